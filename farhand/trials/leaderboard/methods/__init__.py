"""What competes: what a method is, what it may change, those that come with Farhand."""
