"""What is done before and after every solve, whatever the solver."""
