#include "plugin/panels/operation.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QKeyEvent>

#include <csignal>

namespace pcm::host {
namespace {

TEST(Operation, IsAloneAndEscCancels)
{
    QObject receiver;
    {
        Operation operation(nullptr);
        EXPECT_THROW(Operation second(nullptr), Error);
        EXPECT_THROW(Operation::refuse_second(), Error);
        const ProgressFunction progress = operation.progress();
        EXPECT_TRUE(progress({"Reading", 0.5, 10}));
        QKeyEvent other(QEvent::KeyPress, Qt::Key_A, Qt::NoModifier);
        QCoreApplication::sendEvent(&receiver, &other);
        EXPECT_TRUE(progress({"Reading", 0.5, 10}));
        QKeyEvent escape(QEvent::KeyPress, Qt::Key_Escape, Qt::NoModifier);
        QCoreApplication::sendEvent(&receiver, &escape);
        EXPECT_FALSE(progress({"Reading", 0.5, 10}));

        QEvent close(QEvent::Close);
        close.accept();
        QCoreApplication::sendEvent(&receiver, &close);
        EXPECT_FALSE(close.isAccepted());
    }
    EXPECT_NO_THROW(Operation next(nullptr));
}

void handle(int) {}

// A file that grows beyond the system's limit is an error during an operation; the host's own handling stays otherwise.
TEST(Operation, IgnoresTheSignalOfTheFileSizeLimit)
{
    const auto handler = [] {
        struct sigaction action {};
        EXPECT_EQ(sigaction(SIGXFSZ, nullptr, &action), 0);
        return action.sa_handler;
    };
    ASSERT_EQ(handler(), SIG_DFL);
    {
        const Operation operation(nullptr);
        EXPECT_EQ(handler(), SIG_IGN);
    }
    EXPECT_EQ(handler(), SIG_DFL);
    std::signal(SIGXFSZ, handle);
    {
        const Operation operation(nullptr);
        EXPECT_EQ(handler(), handle);
    }
    EXPECT_EQ(handler(), handle);
    std::signal(SIGXFSZ, SIG_DFL);
}

}  // namespace
}  // namespace pcm::host
