"""A busy window gets the newest state, and every message that is no state."""

from __future__ import annotations

from app.gui.desk.inbox import Inbox
from app.jobs.arm_news import ArmStatus
from app.jobs.host import Host
from app.jobs.messages import Finished, News, Progressed, Warned
from app.jobs.service import Service


def _status(problem):
    return News(ArmStatus(None, None, problem))


def test_of_states_that_wait_only_the_newest_is_handed_on_and_all_else_in_order(qtbot, qapp):
    handed = []
    inbox = Inbox(lambda host, message: handed.append(message), qapp)
    host = Host(Service, "waits", lambda message: None)
    sent = [Progressed("scan", 1, 9), _status("a"), Warned("first"), _status("b"), Progressed("scan", 2, 9)]
    for message in [*sent, Warned("second"), Finished(None)]:
        inbox.put(host, message)
    assert handed == []
    qtbot.waitUntil(lambda: bool(handed))
    assert handed == [Warned("first"), sent[3], sent[4], Warned("second"), Finished(None)]


def test_hosts_do_not_overtake_each_other(qtbot, qapp):
    handed = []
    inbox = Inbox(lambda host, message: handed.append((host, message)), qapp)
    one, other = (Host(Service, name, lambda message: None) for name in ("one", "other"))
    inbox.put(one, _status("one"))
    inbox.put(other, _status("other"))
    qtbot.waitUntil(lambda: len(handed) == 2)
    assert [host for host, _ in handed] == [one, other]
