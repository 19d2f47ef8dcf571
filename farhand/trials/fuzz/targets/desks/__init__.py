"""What people, pages and commands ask a running program for."""
