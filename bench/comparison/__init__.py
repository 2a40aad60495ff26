# SPDX-License-Identifier: Apache-2.0
"""The parts of bench/compare.py: volumes, builds, measurements, sections, the page and its plots."""
