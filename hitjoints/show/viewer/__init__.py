"""The arm, a hit and its motion in the browser, or as a page."""
