// tests/failing_calls.cpp — loaded before a program's libraries: makes one of its calls that write files fail, or
// all from one on, or one of its allocations. $LENSPROOF_FAIL says which: "write 7" the seventh alone, "writes 7" it
// and every later one, "new 7" the seventh allocation. Where a call was made to fail, the file $LENSPROOF_FAILED
// appears.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

std::atomic<long> calls = 0;
std::atomic<bool> in_main = false;             // what runs before has nobody to catch it,
thread_local bool is_loading_library = false;  // nor has what runs while a library is loaded

// By the system's own numbers: the calls below would count themselves.
void leave_mark() {
    if (const char* mark = std::getenv("LENSPROOF_FAILED")) {
        ::syscall(SYS_close, ::syscall(SYS_open, mark, O_WRONLY | O_CREAT, 0600));
    }
}

bool is_turn(const char* kind) {
    const char* asked = std::getenv("LENSPROOF_FAIL");
    const std::size_t length = std::strlen(kind);
    if (!in_main || is_loading_library || asked == nullptr || std::strncmp(asked, kind, length) != 0) {
        return false;
    }
    const bool goes_on = asked[length] == 's';
    const long wanted = std::strtol(asked + length + (goes_on ? 1 : 0), nullptr, 10);
    const long call = ++calls;
    if (call < wanted || (call > wanted && !goes_on)) {
        return false;
    }
    leave_mark();
    return true;
}

/// As on a full disk: what is written to a regular file, and to no standard stream.
bool fails(int descriptor) {
    struct stat status {};
    if (descriptor <= STDERR_FILENO || ::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) ||
        !is_turn("write")) {
        return false;
    }
    errno = ENOSPC;
    return true;
}

bool fails() {
    if (!is_turn("write")) {
        return false;
    }
    errno = ENOSPC;
    return true;
}

template <class Function>
Function next(Function /*same*/, const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

using Main = int (*)(int, char**, char**);
Main program_main = nullptr;

int noted_main(int argc, char** argv, char** environment) {
    in_main = true;
    return program_main(argc, argv, environment);
}

}  // namespace

extern "C" {

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*end)(), void (*loader_end)(),
                      void* stack_end) {
    program_main = main;
    return next(&__libc_start_main, "__libc_start_main")(noted_main, argc, argv, init, end, loader_end, stack_end);
}

void* dlopen(const char* file, int mode) {
    static const auto real = next(&dlopen, "dlopen");
    is_loading_library = true;
    void* const library = real(file, mode);
    is_loading_library = false;
    return library;
}

ssize_t write(int descriptor, const void* bytes, size_t size) {
    static const auto real = next(&write, "write");
    return fails(descriptor) ? -1 : real(descriptor, bytes, size);
}

ssize_t writev(int descriptor, const iovec* pieces, int count) {
    static const auto real = next(&writev, "writev");
    return fails(descriptor) ? -1 : real(descriptor, pieces, count);
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* stream) {
    static const auto real = next(&fwrite, "fwrite");
    return fails(::fileno(stream)) ? 0 : real(bytes, size, count, stream);
}

int fflush(FILE* stream) {
    static const auto real = next(&fflush, "fflush");
    return stream != nullptr && fails(::fileno(stream)) ? EOF : real(stream);
}

int fsync(int descriptor) {
    static const auto real = next(&fsync, "fsync");
    return fails() ? -1 : real(descriptor);
}

int rename(const char* from, const char* to) {
    static const auto real = next(&rename, "rename");
    return fails() ? -1 : real(from, to);
}

int mkdir(const char* folder, mode_t mode) {
    static const auto real = next(&mkdir, "mkdir");
    return fails() ? -1 : real(folder, mode);
}

int open(const char* file, int flags, ...) {
    static const auto real = next(&open, "open");
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return (flags & O_CREAT) != 0 && fails() ? -1 : real(file, flags, mode);
}

}  // extern "C"

void* operator new(std::size_t size) {
    void* memory = is_turn("new") ? nullptr : std::malloc(size);
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    return memory;
}

void operator delete(void* memory) noexcept {
    std::free(memory);
}

void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}
