#include "plugin/scene/selection_text.h"

#include "pcm/system/error.h"

#include <QStringList>

namespace pcm::host {

namespace {

Vec3d three_numbers(const QStringList& numbers, int from)
{
    Vec3d v{};
    for (int a = 0; a < 3; ++a) {
        bool good = false;
        v[static_cast<std::size_t>(a)] = numbers[from + a].toDouble(&good);
        if (!good)
            throw Error(ErrorCode::invalid_argument, {},
                        "the box has '" + numbers[from + a].toStdString() + "' instead of a number");
    }
    return v;
}

std::optional<Box3d> parse_box(const QString& text)
{
    const QStringList numbers = text.simplified().split(' ', Qt::SkipEmptyParts);
    if (numbers.isEmpty()) return std::nullopt;
    if (numbers.size() != 6)
        throw Error(ErrorCode::invalid_argument, {},
                    "the box has " + std::to_string(numbers.size()) + " numbers, not 6",
                    "give the smallest x y z, then the largest x y z");
    return Box3d{three_numbers(numbers, 0), three_numbers(numbers, 3)};
}

}  // namespace

Selection parse_selection(const QString& box, const QString& where)
{
    Selection selection;
    selection.box = parse_box(box);
    refuse_impossible_box(selection);
    for (const QString& condition : where.split(';', Qt::SkipEmptyParts))
        if (!condition.trimmed().isEmpty())
            selection.where.push_back(parse_condition(condition.trimmed().toStdString()));
    return selection;
}

}  // namespace pcm::host
