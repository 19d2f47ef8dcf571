"""What all programs share: time, links, messages, scenarios. Imports none of the others."""
