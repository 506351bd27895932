// engine/base/confined.h — files that nobody vouches for are decoded in processes that can do little else.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace lensproof {

/// From now on the files that are read may have been made to attack their readers: libraries decode them in confined
/// processes (below), and files refer to none outside their own folders (`referred_file`).
///
/// Starts the process that those are forked from, which has no threads and ends with this one: to be called before the
/// first thread is started. Returns whether this system lets a process give up its files (Landlock, Linux 5.13); where
/// it does not, the limits on memory and time remain.
bool distrust_files();

[[nodiscard]] bool files_are_distrusted();

/// One end of the way between a process and a confined one: messages that arrive whole and in order.
class MessageChannel {
  public:
    /// `file`: that is read, for errors.
    MessageChannel(int socket, std::filesystem::path file) : socket_(socket), file_(std::move(file)) {}
    MessageChannel(MessageChannel&& other) noexcept;
    MessageChannel& operator=(MessageChannel&&) = delete;
    ~MessageChannel();

    void send(std::string_view message);

    /// What the other end's `receive` throws as an InputError.
    void refuse(std::string_view message);

    /// A message of at most `most` bytes, or of just `count`. Throws InputError that the other end refused with; and
    /// where it has gone, or sends what it should not.
    std::string receive(std::size_t most = std::size_t{1} << 40);
    void receive(char* bytes, std::size_t count);

  private:
    enum class Kind : char { message, refusal };

    void send(Kind kind, std::string_view message);
    std::size_t receive_length();
    void receive_all(char* bytes, std::size_t count);

    int socket_;
    std::filesystem::path file_;
};

/// What a confined process does with the file: takes requests from the channel and answers them. An InputError that it
/// throws is thrown by the asker's `receive`.
using ConfinedWork = void (*)(const std::filesystem::path& file, MessageChannel& channel);

/// Starts `work` on `file` in a process that may read `readable` (a file, or a folder and all in it) and no other file,
/// writes none, starts no program, opens no connection over TCP, takes half of the memory that there is and a minute of
/// a processor's time. Limits that the system does not have do not hold (see distrust_files). `prepare` is called
/// before, where other files may be read yet, in the process that confined ones are forked from: it loads what they
/// need.
MessageChannel start_confined(ConfinedWork work, const std::filesystem::path& file,
                              const std::filesystem::path& readable, void (*prepare)() = nullptr);

}  // namespace lensproof
