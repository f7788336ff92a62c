// A plot of points over a line: how far along it they are, and how high. The wheel zooms, dragging moves the plot,
// dragging with Shift or the right button measures, and a double click shows everything.
#pragma once

#include "plugin/tools/measure/plot_axis.h"

#include <QImage>
#include <QWidget>

#include <optional>
#include <vector>

namespace pcm::host {

struct PlotPoint {
    double station = 0;  // along the line
    double height = 0;
    QRgb colour = 0;
};

class ProfilePlot : public QWidget {
    Q_OBJECT

public:
    explicit ProfilePlot(QWidget* parent = nullptr);

    // `unit` of both axes, or empty.
    void show_points(std::vector<PlotPoint> points, const QString& title, const QString& unit);
    std::size_t size() const { return points_.size(); }
    bool equal_scale() const { return equal_; }
    void set_equal_scale(bool equal);
    void fit();
    const PlotFrame& frame() const { return frame_; }

    // What the plot measures: from where the button was pressed to where the mouse is.
    struct Span {
        double station0, height0, station1, height1;
    };
    const std::optional<Span>& span() const { return span_; }
    // "station 12.3, height 45.6 m", with the digits that a pixel resolves.
    QString text_at(const QPointF& pixel) const;
    QString text_of_span() const;

    QSize sizeHint() const override { return {900, 420}; }
    QSize minimumSizeHint() const override { return {240, 160}; }

signals:
    void pointed(const QString& text);  // at the mouse; empty outside

protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void leaveEvent(QEvent* event) override;

private:
    void lay_out();
    void changed();
    void draw_points();
    void draw_axes(QPainter& painter) const;
    void draw_pointer(QPainter& painter) const;
    QString number(double value, double per_pixel) const;

    std::vector<PlotPoint> points_;
    QString title_, unit_;
    PlotFrame frame_;
    QImage picture_;  // picture of the points, in the pixels of the screen
    bool picture_is_old_ = true;
    bool equal_ = true;
    bool fitted_ = true;  // the user has not moved it since
    std::optional<QPointF> mouse_, pressed_;
    std::optional<Span> span_;
    bool measuring_ = false;
};

}  // namespace pcm::host
