"""What several studies share: sweeps that are made here, metrics of a record, paths over stiffness."""
