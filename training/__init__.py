"""What is run to make files that the program ships; the program itself never imports it."""
