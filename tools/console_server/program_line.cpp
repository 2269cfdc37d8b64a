// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/program_line.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

namespace capstan::tools {

using boost::system::error_code;

ProgramLine::ProgramLine(boost::asio::io_context& io, int descriptor, std::function<void(std::string_view)> heard)
    : line_(io), heard_(std::move(heard)) {
  line_.assign(descriptor);
  line_.non_blocking(true);
}

void ProgramLine::read() {
  line_.async_read_some(boost::asio::buffer(in_),
                        [self = shared_from_this()](const error_code& error, std::size_t count) {
                          if (!self->heard_) {
                            return;
                          }
                          self->heard_({self->in_.data(), error ? 0 : count});
                          if (!error) {
                            self->read();
                          }
                        });
}

void ProgramLine::send(std::string_view bytes) {
  if (line_.is_open() && backlog_.has_room_for(bytes.size())) {
    backlog_.add(bytes.size(), Backlog::Clock::now());
    waiting_ += bytes;
    write();
  }
}

void ProgramLine::write() {
  constexpr std::size_t kMostAtOnce = std::size_t{16} << 10U;  // so that a program that takes is seen to
  if (!going_.empty() || waiting_.empty()) {
    return;
  }
  going_ = waiting_.substr(0, kMostAtOnce);
  waiting_.erase(0, going_.size());
  boost::asio::async_write(line_, boost::asio::buffer(going_),
                           [self = shared_from_this()](const error_code& error, std::size_t count) {
                             self->backlog_.take(count, Backlog::Clock::now());
                             self->going_.clear();
                             if (!error) {
                               self->write();
                             }
                           });
}

void ProgramLine::close() {
  heard_ = nullptr;
  error_code ignored;
  line_.close(ignored);
}

}  // namespace capstan::tools
