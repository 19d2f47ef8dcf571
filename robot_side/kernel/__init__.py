"""What runs at every tick of an arm, compiled: kinematics, the quadratic program, the velocity law.

Functions of arrays only; nothing throws, and what cannot be done is a status. Every constant that they use is in this
folder (see common/compiled.py).
"""
