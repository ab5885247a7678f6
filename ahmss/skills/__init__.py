"""How a body acts: what the shipped algorithms share, and an author may use.

Stepping up to things, reaching, closing a hand, keeping arms out of what is near, sitting, meeting people.
"""
