"""A factorial sweep, a balanced fraction of it that is run, and what its factors do
(docs/results/method/ablation.md).
"""
