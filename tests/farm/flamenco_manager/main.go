// SPDX-License-Identifier: GPL-3.0-or-later

// What Flamenco's manager does with a job compiler script: gives it a job's settings and prints the tasks that it makes of them, as JSON.
//
//	flamenco_manager SCRIPT.js SETTINGS.json
package main

import (
	"encoding/json"
	"fmt"
	"os"

	"github.com/dop251/goja"
)

type command struct {
	Name       string                 `json:"name"`
	Parameters map[string]interface{} `json:"parameters"`
}

type task struct {
	Name         string     `json:"name"`
	Type         string     `json:"type"`
	Commands     []*command `json:"commands"`
	Dependencies []string   `json:"dependencies"`
}

func (t *task) AddCommand(c *command) { t.Commands = append(t.Commands, c) }

func (t *task) AddDependency(other *task) { t.Dependencies = append(t.Dependencies, other.Name) }

type job struct {
	Settings map[string]interface{}
	tasks    []*task
}

func (j *job) AddTask(t *task) { j.tasks = append(j.tasks, t) }

type setting struct {
	Key      string      `json:"key"`
	Type     string      `json:"type"`
	Required bool        `json:"required"`
	Default  interface{} `json:"default"`
	Choices  []string    `json:"choices"`
	Eval     string      `json:"eval"`
}

type jobType struct {
	Label    string    `json:"label"`
	Settings []setting `json:"settings"`
}

func author(vm *goja.Runtime) *goja.Object {
	made := vm.NewObject()
	// Flamenco has a type for every task, since workers choose by it.
	made.Set("Task", func(name string, kind string) *task { return &task{name, kind, []*command{}, []string{}} })
	made.Set("Command", func(name string, parameters map[string]interface{}) *command { return &command{name, parameters} })
	return made
}

// compile runs a script on the settings of a job, with the defaults of those that are not given.
func compile(script string, given map[string]interface{}) (*jobType, *job, error) {
	source, err := os.ReadFile(script)
	if err != nil {
		return nil, nil, err
	}
	vm := goja.New()
	vm.SetFieldNameMapper(goja.UncapFieldNameMapper())
	vm.Set("author", author(vm))
	if _, err := vm.RunScript(script, string(source)); err != nil {
		return nil, nil, err
	}
	value, err := vm.RunString("JSON.stringify(JOB_TYPE)")
	if err != nil {
		return nil, nil, err
	}
	var kind jobType
	if err := json.Unmarshal([]byte(value.String()), &kind); err != nil {
		return nil, nil, err
	}
	made := &job{Settings: map[string]interface{}{}}
	for _, entry := range kind.Settings {
		value, set := given[entry.Key]
		if !set {
			value = entry.Default
		}
		if value == nil && entry.Required {
			return nil, nil, fmt.Errorf("the setting %s is required", entry.Key)
		}
		made.Settings[entry.Key] = value
		delete(given, entry.Key)
	}
	for key := range given {
		return nil, nil, fmt.Errorf("there is no setting %s", key)
	}
	compileJob, callable := goja.AssertFunction(vm.Get("compileJob"))
	if !callable {
		return nil, nil, fmt.Errorf("there is no function compileJob")
	}
	_, err = compileJob(nil, vm.ToValue(made))
	return &kind, made, err
}

func run(arguments []string) error {
	if len(arguments) != 2 {
		return fmt.Errorf("usage: flamenco_manager SCRIPT.js SETTINGS.json")
	}
	text, err := os.ReadFile(arguments[1])
	if err != nil {
		return err
	}
	var given map[string]interface{}
	if err := json.Unmarshal(text, &given); err != nil {
		return err
	}
	kind, made, err := compile(arguments[0], given)
	if err != nil {
		return err
	}
	return json.NewEncoder(os.Stdout).Encode(map[string]interface{}{"type": kind, "tasks": made.tasks})
}

func main() {
	if err := run(os.Args[1:]); err != nil {
		fmt.Fprintln(os.Stderr, err)
		os.Exit(1)
	}
}
