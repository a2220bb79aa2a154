"""What the pages share: the open session, the running job, the robot's link. No widgets here."""
