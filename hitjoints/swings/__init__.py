"""The swing: a motion from rest to rest that strikes, within all limits, and can be sent."""
