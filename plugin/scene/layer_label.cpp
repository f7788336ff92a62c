#include "plugin/scene/layer_label.h"

#include "pcm/system/text.h"
#include "pcm/system/tree_folder.h"

#include <QFileInfo>
#include <QRegularExpression>
#include <QStringList>

namespace pcm::host {

namespace {

QString text_of(const std::filesystem::path& path) { return QString::fromStdString(path.string()); }

// MeshLab numbers layers of one name: "city(1).pct", "city (1)".
QString without_number(QString name)
{
    static const QRegularExpression number(R"( ?\([0-9]+\)(?=\.[^.]*$|$))");
    return name.remove(number);
}

}  // namespace

QString tree_label(const QString& present, const std::filesystem::path& opened, const std::filesystem::path& tree,
                   std::uint64_t shown, std::uint64_t total)
{
    static const QRegularExpression counts(R"( \([0-9,]+ of [0-9,]+\)$)");
    const bool from_file =
        !opened.empty() && tree_folder_of(opened) == opened && opened.extension() != tree.extension();
    const QString automatic = text_of(from_file ? opened.stem() : tree.stem());
    const QStringList made{automatic, text_of(opened), text_of(opened.filename()), text_of(tree.filename()),
                           text_of(tree)};
    QString name = present;
    const bool had_counts = name.contains(counts);
    name.remove(counts);
    if (name.isEmpty() || made.contains(name) || made.contains(without_number(name)))
        name = automatic;
    else if (!had_counts)
        return present;
    if (shown == total) return name;
    return name + " (" + QString::fromStdString(grouped(shown)) + " of " + QString::fromStdString(grouped(total)) + ")";
}

}  // namespace pcm::host
