"""A node of a ROS 2 graph as rmw_zenoh writes it: keys, tokens, attachments, publishers, subscriptions, services."""
