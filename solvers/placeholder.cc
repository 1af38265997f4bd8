namespace prospect {}
