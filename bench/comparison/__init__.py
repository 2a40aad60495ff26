# SPDX-License-Identifier: Apache-2.0
"""The modules of bench/compare.py: volumes, builds, measurements, sections, page and plots."""
