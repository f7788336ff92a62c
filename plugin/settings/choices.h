// Settings that are one row of a table of the core: splat_modes(), colour_modes(), colour_ramps().
#pragma once

#include "plugin/scene/parameters.h"

#include <QStringList>

#include <algorithm>

namespace pcm::host {

template <class Table>
QStringList labels_of(const Table& rows)
{
    QStringList labels;
    for (const auto& row : rows) labels << row.label;
    return labels;
}

// The number of the chosen one of `rows`; the nearest valid one where the stored number is none.
template <class Table>
int choice_of(const Parameters& parameters, const char* name, const Table& rows)
{
    return std::clamp(parameters.whole(name), 0, int(rows.size()) - 1);
}

}  // namespace pcm::host
