// The pcm command: build, convert, info, verify, generate, append, compact, delete, repair, query, set, transform.
//
// Exit codes: 0 all is well; 1 it is not (the message says what); 2 the command line makes no sense; 130 cancelled.
#include "cli/common.h"
#include "cloud/error.h"

#include <cstdio>
#include <new>

int main(int argc, char** argv)
{
    CLI::App app{"Out-of-core point clouds"};
    app.name("pcm");
    app.require_subcommand(1);
    int result = 0;
    pcm::cli::add_build(app, result);
    pcm::cli::add_convert(app, result);
    pcm::cli::add_info(app, result);
    pcm::cli::add_verify(app, result);
    pcm::cli::add_append(app, result);
    pcm::cli::add_compact(app, result);
    pcm::cli::add_delete(app, result);
    pcm::cli::add_repair(app, result);
    pcm::cli::add_query(app, result);
    pcm::cli::add_set(app, result);
    pcm::cli::add_transform(app, result);
    pcm::cli::add_generate(app, result);

    const char* problem = nullptr;
    std::string text;
    try {
        app.parse(argc, argv);
        return result;
    } catch (const CLI::ParseError& error) {
        const int code = app.exit(error);
        return code == 0 ? 0 : 2;
    } catch (const pcm::Error& error) {
        text = error.what();
        problem = text.c_str();
        result = error.code() == pcm::ErrorCode::cancelled ? 130 : 1;
    } catch (const std::bad_alloc&) {
        problem = "out of memory";
        result = 1;
    } catch (const std::exception& error) {
        text = error.what();
        problem = text.c_str();
        result = 1;
    }
    std::fprintf(stderr, "pcm: %s\n", problem);
    return result;
}
