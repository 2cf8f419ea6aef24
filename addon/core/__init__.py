# SPDX-License-Identifier: GPL-3.0-or-later
"""Decisions that need no Blender: settings, reports and the command line. No module here imports bpy."""
