"""The optimisation problems, and the one door to the solver that answers them."""
