// The tool Measure: clicks on points make measures, and its panel has the list of them.
//
// A click without a movement picks a point; dragging and the wheel move MeshLab's camera. Ending the tool keeps the
// measures. GUI thread; profiles and volumes are computed on a thread of their own.
#pragma once

#include "plugin/edit/measure/cloud_work.h"
#include "plugin/edit/measure/draft.h"
#include "plugin/edit/measure/measure_panel.h"
#include "plugin/host/picker.h"

#include "plugin/edit/view_tool.h"

#include <QPointer>

#include <functional>
#include <memory>
#include <optional>

class QMouseEvent;

namespace pcm::host {

class MeasureBook;
class ProfileWindow;
struct ProfileData;

class MeasureTool : public ViewTool {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    MeasureTool();
    ~MeasureTool() override;
    bool StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void Decorate(MeshModel&, GLArea* view, QPainter* painter) override;

    void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view) override;
    void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view) override;

protected:
    // Moves without a button, double clicks, and Esc, which MeshLab has as a shortcut.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    MeasureBook& book() const;
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void make_panel();
    void show_panel();
    void show_draft();
    void press(MeasurePanel::Button button);
    void change_kind();

    void click(const QPoint& place);
    void take(int click, const PickAnswer& answer);
    void end();
    bool cancel();  // what is being made or computed; false if nothing is
    void clear_draft();
    bool take_back();
    void finish();  // makes a measure of the complete draft
    void keep(Measure measure);
    void write();

    // In measure_clouds.cpp.
    MeshModel& layer_of(const Measure& measure) const;
    double width_for(const Measure& measure) const;
    void measure_cloud(std::size_t index);  // plots a profile, finds a volume
    void plot(const Measure& measure);
    void write_points(const std::shared_ptr<const ProfileData>& data, const QString& extension, ProfileWindow& window);
    void find_volume(const Measure& measure);
    void take_volume(const Measure& measure, const std::vector<MeasureValue>& values);
    void begin(const QString& what, const std::function<CloudWork::Result(const ProgressFunction&)>& work);

    QPointer<MeasurePanel> panel_;
    Draft draft_;
    std::unique_ptr<QObject> picks_;  // parent of the contexts of picks that are not answered
    std::optional<int> first_layer_;  // that the draft's first point was picked on
    CloudWork work_;
    std::unique_ptr<QMouseEvent> pressed_;  // has not moved far enough for a drag
    QPoint mouse_;
    bool tracked_mouse_ = false;
};

}  // namespace pcm::host
