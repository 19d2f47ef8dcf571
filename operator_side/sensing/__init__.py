"""What the operator's side knows: of the robot by its messages, of the link by echoed stamps, of what is in the way."""
