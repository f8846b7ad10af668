"""A scene at many points, on all cores or a cluster, and the results in one table."""
