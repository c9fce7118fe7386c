"""The `record` executable: records a bag, or repairs one."""
