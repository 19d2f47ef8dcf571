"""Certificates, TLS, rights, and what is said of those who are refused."""
