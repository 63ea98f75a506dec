"""The paper's experiments, and its numbers beside ours."""
