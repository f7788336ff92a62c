#include "plugin/scene/measure_book.h"

#include "plugin/scene/annotations.h"
#include "plugin/scene/drawn_measures.h"
#include "plugin/scene/project_parts.h"
#include "plugin/scene/scene_view.h"

#include <utility>

namespace pcm::host {

namespace {

const char* const element = "PointCloudMeasures";
const char* const owner = "measure";

}  // namespace

MeasureBook::MeasureBook(Scene& scene) : ListBook(scene)
{
    unit_ = length_unit_of(scene);
    // Other layers may have other units.
    connect(&scene, &Scene::cloud_attached, this, &MeasureBook::refresh_unit);
    connect(&scene, &Scene::cloud_detached, this, &MeasureBook::refresh_unit);
}

void MeasureBook::refresh_unit()
{
    LengthUnit unit = length_unit_of(scene_);
    if (unit.symbol == unit_.symbol && unit.warning == unit_.warning && unit.is_stated == unit_.is_stated) return;
    unit_ = std::move(unit);
    show();
}

void MeasureBook::show()
{
    std::vector<Measure> measures;
    for (std::size_t i = 0; i < list().size(); ++i) measures.push_back(list()[i]);
    scene_.part<Annotations>().set(owner, drawn_measures(measures, unit_.symbol, selected()));
    emit changed();
}

void keep_measures_in_projects()
{
    static bool once = false;
    if (std::exchange(once, true)) return;
    add_project_part({element,
                      [](Scene& scene) {
                          const MeasureList& list = scene.part<MeasureBook>().list();
                          return list.empty() ? QString() : QString::fromStdString(list.text());
                      },
                      [](Scene& scene, const QString& text) {
                          MeasureList list = MeasureList::parse(text.toStdString());
                          scene.part<MeasureBook>().replace(std::move(list));
                      }});
}

}  // namespace pcm::host
