# SPDX-License-Identifier: GPL-3.0-or-later
from .core.cli import main

main()
