"""Bridges to other worlds, each a program's parts."""
