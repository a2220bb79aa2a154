import pytest

from app.jobs.library_work import LibraryWork
from app.jobs.service import JobReporter
from app.library.exchange import report_is_current
from app.library.session_folder import remembered_parameters
from core.session import Session

pytestmark = pytest.mark.system


@pytest.fixture
def work():
    service = LibraryWork(lambda news: None)
    yield service
    service.close()


@pytest.fixture
def face():
    return JobReporter(lambda message: None)


def test_a_report_that_is_missing_is_written_before_it_is_exported(block_session, work, face, tmp_path):
    digest = Session.open(block_session).record("containability").digest
    parameters = remembered_parameters(block_session)
    html, pdf = tmp_path / "out.html", tmp_path / "out.pdf"
    assert work.export_html(face, block_session, html) == html
    assert report_is_current(block_session)
    assert "Not an open container" in html.read_text()
    assert Session.open(block_session).record("containability").digest == digest  # nothing was imagined anew
    assert remembered_parameters(block_session) == parameters
    html.write_text("an old export")
    work.export_html(face, block_session, html)  # the dialog has asked whether to replace it
    assert "Not an open container" in html.read_text()
    work.export_pdf(face, block_session, pdf)
    assert pdf.read_bytes().startswith(b"%PDF")


def test_a_zip_goes_there_and_back(block_session, work, face, tmp_path):
    archive = work.export_zip(face, block_session, tmp_path / "block.zip")
    imported = work.import_zip(face, archive, tmp_path / "sessions")
    assert Session.open(imported).record("scan").digest == Session.open(block_session).record("scan").digest
