#include "plugin/panels/message_area.h"

#include <QLabel>
#include <QScrollBar>

namespace pcm::host {

MessageArea::MessageArea(const char* object_name, int lines) : label_(new QLabel)
{
    label_->setObjectName(object_name);
    label_->setWordWrap(true);
    label_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    label_->setMargin(2);
    label_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    label_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);  // a long word is cut, not the panel widened
    setWidget(label_);
    setWidgetResizable(true);
    setFrameShape(QFrame::StyledPanel);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFocusPolicy(Qt::NoFocus);
    setFixedHeight(lines * fontMetrics().lineSpacing() + 2 * (frameWidth() + label_->margin()));
}

void MessageArea::say(const QString& text)
{
    label_->setText(text);
    setToolTip(text);
    verticalScrollBar()->setValue(0);
}

}  // namespace pcm::host
