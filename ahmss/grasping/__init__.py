"""Hands on things: how far anything is from a shape, and how palm and fingers meet it."""
