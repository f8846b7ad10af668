"""Run a scene at many points, on all cores or on a cluster, and collect the results in one table."""
