"""The robots that come with hitjoints: one TOML each, and our own URDFs."""
