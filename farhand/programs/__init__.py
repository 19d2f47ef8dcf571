"""The programs: sessions, links, nodes, results at the end."""
