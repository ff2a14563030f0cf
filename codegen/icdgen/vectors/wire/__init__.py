"""What the protocol layer is asked: requests made from the protocol facts of a node, a module a theme."""
