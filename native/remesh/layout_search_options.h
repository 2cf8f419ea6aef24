// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/base/base_domain.h"
#include "layout/search/layout_search.h"
#include "remesh/candidate.h"

namespace hybrid_mesh {

// How the base's layout is searched.
LayoutSearchOptions layout_search_options(const RemeshOptions& options, const Budget& budget, const BaseDomain& base, const BaseRequest& request);

}  // namespace hybrid_mesh
