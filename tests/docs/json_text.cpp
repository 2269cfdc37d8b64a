// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/docs/json_text.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace capstan {
namespace {

using Json = nlohmann::ordered_json;

auto last_part(const std::string& reference) -> std::string {
  return reference.substr(reference.find_last_of('/') + 1);
}

/// The definition that a value is of, and none where it is described in place.
auto definition_of(const Json& value) -> std::string {
  if (value.contains("$ref")) {
    return last_part(value.at("$ref"));
  }
  for (const char* several : {"anyOf", "allOf"}) {
    if (value.contains(several) && value.at(several).front().contains("$ref")) {
      return last_part(value.at(several).front().at("$ref"));
    }
  }
  return {};
}

/// The value itself, where it may be null beside.
auto told(const Json& value) -> const Json& {
  return value.contains("anyOf") ? value.at("anyOf").front() : value;
}

auto may_be_null(const Json& value) -> bool {
  return (value.contains("anyOf") && value.at("anyOf").back().value("type", Json()) == "null") ||
         (value.contains("type") && value.at("type").is_array());
}

auto words_of(const Json& values) -> std::string {
  std::string words;
  for (const auto& value : values) {
    words += (words.empty() ? "`" : ", `") + value.get<std::string>() + "`";
  }
  return words;
}

auto type_of(const Json& value) -> std::string {
  std::string type = definition_of(value);
  if (type.empty()) {
    const Json& itself = told(value);
    if (itself.contains("const")) {
      type = "`" + itself.at("const").get<std::string>() + "`";
    } else if (itself.contains("enum")) {
      type = words_of(itself.at("enum"));
    } else {
      const Json& name = itself.at("type");
      type = name.is_array() ? name.front() : name;
    }
    if (type == "array") {
      const Json& item = itself.at("items");
      type = "array of " + (definition_of(item).empty() ? item.at("type").get<std::string>() : definition_of(item));
    } else if (type == "object" && itself.contains("additionalProperties")) {
      type = definition_of(itself.at("additionalProperties")) + " by name";
    }
  }
  return type + (may_be_null(value) ? " or null" : "");
}

void add_rows(const Json& object, const std::string& prefix, std::string& text) {
  for (const auto& [name, value] : object.at("properties").items()) {
    text +=
        "| `" + prefix + name + "` | " + type_of(value) + " | " + value.value("description", std::string()) + " |\n";
    if (!definition_of(value).empty()) {
      continue;
    }
    const Json& itself = told(value);
    if (itself.contains("properties")) {
      add_rows(itself, prefix + name + ".", text);
    } else if (itself.contains("items") && itself.at("items").contains("properties")) {
      add_rows(itself.at("items"), prefix + name + "[].", text);
    }
  }
}

}  // namespace

auto json_table(const std::string& path) -> std::string {
  std::ifstream file(path);
  const Json schema = Json::parse(file, nullptr, false);
  if (!schema.is_object()) {
    throw std::runtime_error(path + ": no JSON schema can be read there");
  }
  std::string text = "\n### " + schema.at("title").get<std::string>() + "\n\n" +
                     schema.at("description").get<std::string>() + "\n\n| | is | |\n|---|---|---|\n";
  add_rows(schema, "", text);
  for (const auto& [name, value] : schema.at("$defs").items()) {
    text += "\n**" + name + "**: " + (value.contains("properties") ? "" : type_of(value) + ", ") +
            value.value("description", std::string("an object")) + ".\n";
    if (value.contains("properties")) {
      text += "\n| | is | |\n|---|---|---|\n";
      add_rows(value, "", text);
    }
  }
  return text;
}

}  // namespace capstan
