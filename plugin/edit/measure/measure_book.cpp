#include "plugin/edit/measure/measure_book.h"

#include "plugin/edit/measure/drawn_measures.h"
#include "plugin/host/annotations.h"
#include "plugin/host/project_parts.h"
#include "plugin/host/registry.h"

#include <utility>

namespace pcm::host {

namespace {

const char* const element = "PointCloudMeasures";
const char* const owner = "measure";

}  // namespace

MeasureBook::MeasureBook(MeshDocument& document) : QObject(&document), document_(document)
{
    unit_ = length_unit_of(document);
    // Other layers may have other units.
    const auto changed = [this](MeshDocument* changed_document) {
        if (changed_document == &document_) refresh_unit();
    };
    connect(&Registry::instance(), &Registry::attached, this, changed);
    connect(&Registry::instance(), &Registry::detached, this, changed);
}

MeasureBook& MeasureBook::of(MeshDocument& document)
{
    auto* found = document.findChild<MeasureBook*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new MeasureBook(document);
}

void MeasureBook::change(const std::function<void(MeasureList& list)>& step)
{
    MeasureList changed = list_;
    step(changed);
    list_ = std::move(changed);
    if (selected_ && *selected_ >= list_.size()) selected_.reset();
    show();
}

void MeasureBook::replace(MeasureList list)
{
    list_ = std::move(list);
    selected_.reset();
    show();
}

void MeasureBook::select(std::optional<std::size_t> index)
{
    if (index && *index >= list_.size()) index.reset();
    if (index == selected_) return;
    selected_ = index;
    show();
}

void MeasureBook::refresh_unit()
{
    LengthUnit unit = length_unit_of(document_);
    if (unit.symbol == unit_.symbol && unit.warning == unit_.warning && unit.is_stated == unit_.is_stated) return;
    unit_ = std::move(unit);
    show();
}

void MeasureBook::show()
{
    std::vector<Measure> measures;
    for (std::size_t i = 0; i < list_.size(); ++i) measures.push_back(list_[i]);
    Annotations::of(document_).set(owner, drawn_measures(measures, unit_.symbol, selected_));
    emit changed();
}

void keep_measures_in_projects()
{
    static bool once = false;
    if (std::exchange(once, true)) return;
    add_project_part({element,
                      [](MeshDocument& document) {
                          const MeasureList& list = MeasureBook::of(document).list();
                          return list.empty() ? QString() : QString::fromStdString(list.text());
                      },
                      [](MeshDocument& document, const QString& text) {
                          MeasureList list = MeasureList::parse(text.toStdString());
                          MeasureBook::of(document).replace(std::move(list));
                      }});
}

}  // namespace pcm::host
