#include "engine/base/confined.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <mutex>
#include <new>
#include <stdexcept>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/memory.h"

namespace lensproof {

namespace fs = std::filesystem;

namespace {

constexpr ::rlim_t kSeconds = 60;

/// The way to the process that confined ones are forked from.
int& forker() {
    static int socket = -1;
    return socket;
}

/// The kernel's `landlock_ruleset_attr`, with what later kernels added to it.
struct LandlockRules {
    std::uint64_t files;
    std::uint64_t network;  // TCP, since version 4
    std::uint64_t scoped;   // signals and abstract sockets, since version 6
};

/// The version of Landlock that this kernel has; below 1: none.
long landlock_version() {
    return ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
}

/// Gives up every access to files that the kernel knows of, but that of reading `readable`.
void give_up_files(const fs::path& readable) {
    const long version = landlock_version();
    if (version < 1) {
        return;
    }
    // A kernel refuses rights that it does not know: 13 of them at first, a 14th and a 15th with versions 2 and 3, a
    // 16th with 5 (linux/landlock.h).
    const int rights = version < 2 ? 13 : version < 3 ? 14 : version < 5 ? 15 : 16;
    LandlockRules rules{.files = (std::uint64_t{1} << rights) - 1, .network = 3, .scoped = 3};
    const std::size_t size = version < 4 ? 8 : version < 6 ? 16 : sizeof rules;
    const auto ruleset = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &rules, size, 0));
    ::landlock_path_beneath_attr beneath{};
    beneath.parent_fd = ::open(readable.c_str(), O_PATH | O_CLOEXEC);
    beneath.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE;
    if (fs::is_directory(readable)) {
        beneath.allowed_access |= LANDLOCK_ACCESS_FS_READ_DIR;
    }
    if (ruleset == -1 || ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &beneath, 0) != 0 ||
        ::syscall(SYS_landlock_restrict_self, ruleset, 0) != 0) {
        throw InputError(fmt::format("{}: its reader cannot be confined: {}", readable.string(), std::strerror(errno)));
    }
    ::close(beneath.parent_fd);
    ::close(ruleset);
}

void limit(int resource, ::rlim_t most) {
    const ::rlimit limits{.rlim_cur = most, .rlim_max = most};
    ::setrlimit(resource, &limits);
}

void limit_resources() {
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, 0);
    limit(RLIMIT_CPU, kSeconds);
#ifndef __SANITIZE_ADDRESS__  // whose shadow takes terabytes of addresses
    std::size_t pages = 0;    // that are mapped already, most of them libraries'
    std::ifstream("/proc/self/statm") >> pages;
    limit(RLIMIT_AS,
          pages * static_cast<std::size_t>(::sysconf(_SC_PAGE_SIZE)) + static_cast<std::size_t>(memory_bytes() / 2.0));
#endif
}

/// What a forker is asked for: the work and what goes before it, whose places in memory are the same in both processes,
/// with a socket beside them.
class Order {
  public:
    explicit Order(ConfinedWork ordered = nullptr, void (*before)() = nullptr) : what_{ordered, before} {
        message_.msg_iov = &bytes_;
        message_.msg_iovlen = 1;
        message_.msg_control = control_.data();
        message_.msg_controllen = control_.size();
    }
    Order(const Order&) = delete;  // the message points into it
    Order& operator=(const Order&) = delete;

    [[nodiscard]] ConfinedWork work() const { return what_.work; }
    void prepare() const {
        if (what_.prepare != nullptr) {
            what_.prepare();
        }
    }

    void send(int socket) {
        ::cmsghdr* const header = CMSG_FIRSTHDR(&message_);
        header->cmsg_level = SOL_SOCKET;
        header->cmsg_type = SCM_RIGHTS;
        header->cmsg_len = CMSG_LEN(sizeof socket);
        std::memcpy(CMSG_DATA(header), &socket, sizeof socket);
        if (::sendmsg(forker(), &message_, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof what_)) {
            throw std::runtime_error("the process that confined readers are started from has ended");
        }
    }

    /// Its socket; −1 where nobody is left to ask.
    int receive(int orders) {
        int socket = -1;
        const bool is_whole = ::recvmsg(orders, &message_, MSG_CMSG_CLOEXEC) == static_cast<ssize_t>(sizeof what_);
        if (const ::cmsghdr* header = CMSG_FIRSTHDR(&message_); is_whole && header != nullptr) {
            std::memcpy(&socket, CMSG_DATA(header), sizeof socket);
        }
        return socket;
    }

  private:
    struct {
        ConfinedWork work;
        void (*prepare)();
    } what_;
    ::iovec bytes_{.iov_base = &what_, .iov_len = sizeof what_};
    alignas(::cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control_{};
    ::msghdr message_{};
};

/// The confined process, until its asker closes the channel.
void serve(ConfinedWork work, MessageChannel channel) {
    fs::path file;
    try {
        file = channel.receive();
        const fs::path readable = channel.receive();
        limit_resources();
        give_up_files(readable);
        work(file, channel);
    } catch (const InputError& error) {
        channel.refuse(error.what());
    } catch (const std::bad_alloc&) {
        channel.refuse(
            fmt::format("{}: takes more than the {:.0f} MiB of memory that the reader of an untrusted file "
                        "has",
                        file.string(), memory_bytes() / 2.0 / (1 << 20)));
    }
}

/// Forks a process for each order, until the asker has gone. What a terminal sends to all its processes is the asker's
/// to answer.
[[noreturn]] void fork_confined_processes(int orders) {
    for (const int ignored : {SIGINT, SIGTERM, SIGHUP, SIGCHLD, SIGPIPE}) {
        std::signal(ignored, SIG_IGN);
    }
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        ::dup2(nothing, stream);
    }
    ::tzset();  // reads a file, and the times in pictures need it
    for (;;) {
        Order order;
        const int socket = order.receive(orders);
        if (socket == -1) {
            std::_Exit(0);
        }
        order.prepare();
        if (::fork() == 0) {
            ::close(orders);
            serve(order.work(), MessageChannel(socket, {}));
            std::_Exit(0);
        }
        ::close(socket);
    }
}

}  // namespace

bool distrust_files() {
    if (!files_are_distrusted()) {
        std::array<int, 2> ends{};
        std::fflush(nullptr);
        const bool is_made = ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) == 0;
        const ::pid_t child = is_made ? ::fork() : -1;
        if (child == -1) {
            throw std::runtime_error(fmt::format("no confined reader can be started: {}", std::strerror(errno)));
        }
        if (child == 0) {
            ::close(ends[0]);
            fork_confined_processes(ends[1]);
        }
        ::close(ends[1]);
        forker() = ends[0];
    }
    return landlock_version() >= 1;
}

bool files_are_distrusted() {
    return forker() != -1;
}

MessageChannel::MessageChannel(MessageChannel&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), file_(std::move(other.file_)) {}

MessageChannel::~MessageChannel() {
    if (socket_ != -1) {
        ::close(socket_);
    }
}

void MessageChannel::send(std::string_view message) {
    send(Kind::message, message);
}

void MessageChannel::refuse(std::string_view message) {
    send(Kind::refusal, message);
}

void MessageChannel::send(Kind kind, std::string_view message) {
    std::string head(1 + sizeof(std::uint64_t), static_cast<char>(kind));
    const std::uint64_t length = message.size();
    std::memcpy(head.data() + 1, &length, sizeof length);
    for (std::string_view rest : {std::string_view(head), message}) {
        while (!rest.empty()) {
            const ssize_t count = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
            if (count == -1 && errno == EINTR) {
                continue;
            }
            if (count <= 0) {
                return;  // what the other end said last is still to be received
            }
            rest.remove_prefix(static_cast<std::size_t>(count));
        }
    }
}

std::string MessageChannel::receive(std::size_t most) {
    const std::size_t length = receive_length();
    if (length > most) {
        throw InputError(fmt::format("{}: its reader answers with {} bytes, as if the file had taken it over",
                                     file_.string(), length));
    }
    std::string message(length, '\0');
    receive_all(message.data(), length);
    return message;
}

void MessageChannel::receive(char* bytes, std::size_t count) {
    if (const std::size_t length = receive_length(); length != count) {
        throw InputError(
            fmt::format("{}: its reader answers with {} bytes, expected {}, as if the file had taken it "
                        "over",
                        file_.string(), length, count));
    }
    receive_all(bytes, count);
}

std::size_t MessageChannel::receive_length() {
    Kind kind{};
    std::uint64_t length = 0;
    receive_all(reinterpret_cast<char*>(&kind), sizeof kind);
    receive_all(reinterpret_cast<char*>(&length), sizeof length);
    if (kind == Kind::refusal) {
        constexpr std::size_t kLongestMessage = 1 << 16;
        std::string message(std::min(static_cast<std::size_t>(length), kLongestMessage), '\0');
        receive_all(message.data(), message.size());
        throw InputError(message);
    }
    return length;
}

void MessageChannel::receive_all(char* bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t got = ::recv(socket_, bytes, count, 0);
        if (got == -1 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            throw InputError(
                fmt::format("{}: its reader ended before it was through: it crashed, or took more than {} "
                            "s of a processor's time",
                            file_.string(), kSeconds));
        }
        bytes += got;
        count -= static_cast<std::size_t>(got);
    }
}

MessageChannel start_confined(ConfinedWork work, const fs::path& file, const fs::path& readable, void (*prepare)()) {
    static std::mutex one_at_a_time;
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
        throw std::runtime_error(fmt::format("no confined reader can be started: {}", std::strerror(errno)));
    }
    MessageChannel channel(ends[0], file);
    {
        const std::lock_guard lock(one_at_a_time);
        Order(work, prepare).send(ends[1]);
    }
    ::close(ends[1]);
    channel.send(file.string());
    channel.send(readable.string());
    return channel;
}

}  // namespace lensproof
