// What a tool says, in an area of fixed height: messages of any length leave the buttons around it where they are. A
// text that is longer can be scrolled, and is the tooltip. GUI thread.
#pragma once

#include <QScrollArea>
#include <QString>

class QLabel;

namespace pcm::host {

class MessageArea : public QScrollArea {
public:
    // `lines` of text are seen. The label inside has the object name.
    MessageArea(const char* object_name, int lines);

    void say(const QString& text);

private:
    QLabel* label_;
};

}  // namespace pcm::host
