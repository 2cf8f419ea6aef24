# SPDX-License-Identifier: GPL-3.0-or-later
"""Between bpy and numpy: the only modules that call foreach_get and foreach_set."""
