#include "plugin/tools/measure/profile_window.h"

#include "pcm/cad/dxf_file.h"

#include "pcm/system/error.h"
#include "pcm/system/output_file.h"
#include "plugin/scene/text.h"

#include <QBuffer>
#include <QCheckBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QImageWriter>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

namespace pcm::host {

ProfileWindow::ProfileWindow(QWidget* parent, std::shared_ptr<const ProfileData> data)
    : QWidget(parent, Qt::Window), data_(std::move(data)), plot_(new ProfilePlot), place_(new QLabel)
{
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(data_->title + " - Profile");
    setObjectName("PointCloudProfileWindow");
    plot_->setObjectName("PointCloudProfilePlot");
    plot_->setToolTip(
        "Dragging moves the plot, the wheel zooms; without equal scales Shift zooms the heights alone and "
        "Ctrl the line. Dragging with Shift or the right button measures. A double click shows all.");
    plot_->show_points(data_->points, data_->title, data_->unit);
    auto* buttons = new QHBoxLayout;
    const auto add = [&](const char* text, const char* tooltip) {
        auto* button = new QPushButton(text);
        button->setToolTip(tooltip);
        buttons->addWidget(button);
        return button;
    };
    connect(add("Show all", "Shows all points of the profile."), &QPushButton::clicked, plot_, &ProfilePlot::fit);
    auto* equal = new QCheckBox("Equal scales");
    equal->setToolTip("A unit of height is as long as one along the line. Default on; off stretches the heights.");
    equal->setChecked(plot_->equal_scale());
    connect(equal, &QCheckBox::toggled, plot_, &ProfilePlot::set_equal_scale);
    buttons->addWidget(equal);
    buttons->addStretch();
    connect(add("Points as CSV", "Writes all points of the profile: along, across, x, y, z, attributes."),
            &QPushButton::clicked, this, [this] { emit wanted("csv"); });
    if (writes_dxf())
        connect(add("Points as DXF", "Writes all points of the profile as a drawing of (along, height)."),
                &QPushButton::clicked, this, [this] { emit wanted("dxf"); });
    connect(add("Picture", "Saves the plot as it is shown."), &QPushButton::clicked, this,
            &ProfileWindow::ask_for_picture);
    auto* words = new QLabel(data_->words);
    words->setObjectName("PointCloudProfileWords");
    words->setWordWrap(true);
    place_->setObjectName("PointCloudProfilePlace");
    place_->setAlignment(Qt::AlignRight);
    connect(plot_, &ProfilePlot::pointed, place_, &QLabel::setText);
    auto* line = new QHBoxLayout;
    line->addWidget(words, 3);
    line->addWidget(place_, 2);
    auto* column = new QVBoxLayout(this);
    column->addLayout(buttons);
    column->addWidget(plot_, 1);
    column->addLayout(line);
}

void ProfileWindow::say(const QString& text) { place_->setText(text); }

void ProfileWindow::save_picture(const QString& file) const
{
    QBuffer picture;
    QImageWriter writer(&picture, QFileInfo(file).suffix().toLatin1());
    if (!writer.write(plot_->grab().toImage()))
        throw Error(ErrorCode::invalid_argument, file.toStdString(),
                    "the picture cannot be written: " + writer.errorString().toStdString(),
                    "choose an extension such as .png");
    OutputFile output(file.toStdString());
    output.append(picture.data().constData(), static_cast<std::size_t>(picture.size()));
    output.finish();
}

void ProfileWindow::ask_for_picture()
{
    const QString file = QFileDialog::getSaveFileName(this, "Save the plot", "profile.png", "Picture (*.png)", nullptr,
                                                      QFileDialog::DontUseNativeDialog);
    if (file.isEmpty()) return;
    try {
        save_picture(file);
        place_->setText("wrote " + file);
    } catch (...) {
        place_->setText(QString::fromStdString(current_error()));
    }
}

}  // namespace pcm::host
