"""Recording against simulation: align, compare, and find what differs."""
