"""Tools for a site: certificates, doctor, robots, tap, handover."""
