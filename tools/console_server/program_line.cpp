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
  if (waiting_.size() + bytes.size() <= kMostWaiting && line_.is_open()) {
    waiting_ += bytes;
    write();
  }
}

void ProgramLine::write() {
  if (!going_.empty() || waiting_.empty()) {
    return;
  }
  going_.swap(waiting_);
  boost::asio::async_write(line_, boost::asio::buffer(going_),
                           [self = shared_from_this()](const error_code& error, std::size_t) {
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
