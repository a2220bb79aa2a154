"""Where the controller listens, and where its arm stands at first."""

DASHBOARD_PORT = 29999
SCRIPT_PORT = 30003
RTDE_PORT = 30004
CONTROL_PORT = 30099
"""The first three are a real controller's; the last takes faults and questions."""
HOME_RAD = (0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0)
