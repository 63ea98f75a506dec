"""The paper's hitting motion, from its start to its end."""
