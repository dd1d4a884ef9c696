"""Tables 5.9 to 5.21 and figures 5.3, 5.5 and 5.7 of Taouil's thesis with this project's robot."""
