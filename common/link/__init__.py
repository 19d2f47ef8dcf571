"""How bytes move: links, Zenoh sessions, requests, presence, ports."""
