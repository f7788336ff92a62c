#include "plugin/panels/clouds/bookmark_list.h"

#include "plugin/scene/bookmarks.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/text.h"

#include <QFile>
#include <QFileDialog>
#include <QGridLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QSaveFile>

#include <stdexcept>

namespace pcm::host {

namespace {

const char* const path_files = "Camera paths (*.json);;All files (*)";

Vec3d origin_of(const Scene& scene) { return scene.origin().value_or(Vec3d{0, 0, 0}); }

}  // namespace

BookmarkList::BookmarkList(QWidget* parent) : QWidget(parent)
{
    auto* rows = new QGridLayout(this);
    rows->setContentsMargins(0, 0, 0, 0);
    table_ = new QTableWidget(0, 1);
    table_->setObjectName("PointCloudBookmarks");
    table_->setHorizontalHeaderLabels({"Bookmark"});
    table_->setToolTip("Cameras with names, kept in the project. A double click looks from there; F2 renames.");
    table_->verticalHeader()->hide();
    table_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->setEditTriggers(QAbstractItemView::EditKeyPressed);
    rows->addWidget(table_, 0, 0, 1, 3);
    connect(table_, &QTableWidget::cellDoubleClicked, this, [this] { go_to(); });
    connect(table_, &QTableWidget::itemChanged, this, [this](QTableWidgetItem* item) {
        if (filling_ || !scene_) return;
        scene_->part<Bookmarks>().rename(std::size_t(item->row()), item->text());
        fill();
    });
    const auto button = [&](int row, int column, const char* text, const char* tooltip,
                            void (BookmarkList::*pressed)()) {
        auto* made = new QPushButton(text);
        made->setToolTip(tooltip);
        rows->addWidget(made, row, column);
        connect(made, &QPushButton::clicked, this, pressed);
    };
    button(1, 0, "Add Bookmark", "Keeps the camera of the current view.", &BookmarkList::add);
    button(1, 1, "Go To Bookmark", "The current view looks from the chosen bookmark.", &BookmarkList::go_to);
    button(1, 2, "Delete Bookmark", "Deletes the chosen bookmark.", &BookmarkList::remove);
    button(2, 0, "Export Bookmarks...",
           "Writes the bookmarks as a camera path in source coordinates, which 'pcmlab render --path' draws.",
           &BookmarkList::write);
    button(2, 1, "Import Bookmarks...", "Adds the cameras of a camera path in source coordinates.",
           &BookmarkList::read);
}

void BookmarkList::refresh(SceneView* view)
{
    Scene* const scene = view ? &view->scene() : nullptr;
    view_ = view;
    if (scene == scene_) return;
    if (scene_) scene_->part<Bookmarks>().disconnect(this);
    scene_ = scene;
    if (scene) connect(&scene->part<Bookmarks>(), &Bookmarks::changed, this, &BookmarkList::fill);
    fill();
}

void BookmarkList::fill()
{
    filling_ = true;
    const int before = chosen();
    static const std::vector<CameraFrame> none;
    const auto& frames = scene_ ? scene_->part<Bookmarks>().all() : none;
    table_->setRowCount(int(frames.size()));
    for (int r = 0; r < int(frames.size()); ++r)
        table_->setItem(r, 0, new QTableWidgetItem(QString::fromStdString(frames[std::size_t(r)].name)));
    if (before >= 0 && before < int(frames.size())) table_->setCurrentCell(before, 0);
    filling_ = false;
}

int BookmarkList::chosen() const { return table_->currentRow(); }

void BookmarkList::guarded(const std::function<void(SceneView& view, Scene& scene)>& work)
{
    if (!view_ || !scene_) return;
    try {
        work(*view_, *scene_);
    } catch (...) {
        scene_->log(LogLevel::warning, QString::fromStdString("Bookmarks: " + current_error()));
    }
}

void BookmarkList::add()
{
    guarded([this](SceneView& view, Scene& scene) {
        scene.part<Bookmarks>().add(frame_of(view, origin_of(scene)), QString());
        table_->setCurrentCell(table_->rowCount() - 1, 0);
    });
}

void BookmarkList::go_to()
{
    guarded([this](SceneView& view, Scene& scene) {
        const auto& frames = scene.part<Bookmarks>().all();
        if (chosen() < 0 || chosen() >= int(frames.size())) return;
        look_from(view, frames[std::size_t(chosen())], origin_of(scene));
    });
}

void BookmarkList::remove()
{
    guarded([this](SceneView&, Scene& scene) {
        if (chosen() >= 0) scene.part<Bookmarks>().remove(std::size_t(chosen()));
    });
}

void BookmarkList::write()
{
    guarded([this](SceneView&, Scene& scene) {
        const QByteArray text = scene.part<Bookmarks>().text().toUtf8();
        if (text.isEmpty()) throw std::runtime_error("there are no bookmarks to export");
        const QString name = QFileDialog::getSaveFileName(this, "Export bookmarks", "bookmarks.json", path_files);
        if (name.isEmpty()) return;
        QSaveFile file(name);
        if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit())
            throw std::runtime_error(name.toStdString() + " cannot be written: " + file.errorString().toStdString());
    });
}

void BookmarkList::read()
{
    guarded([this](SceneView&, Scene& scene) {
        const QString name = QFileDialog::getOpenFileName(this, "Import bookmarks", QString(), path_files);
        if (name.isEmpty()) return;
        QFile file(name);
        if (!file.open(QIODevice::ReadOnly))
            throw std::runtime_error(name.toStdString() + " cannot be read: " + file.errorString().toStdString());
        scene.part<Bookmarks>().add_text(QString::fromUtf8(file.readAll()), name);
    });
}

}  // namespace pcm::host
